"""What a sweep shows: its figures, sensitivities and capability."""
