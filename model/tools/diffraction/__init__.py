"""What an X-ray diffractometer would measure."""
