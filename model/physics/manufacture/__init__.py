"""What coiling, stress relief and peening leave in the wire."""
