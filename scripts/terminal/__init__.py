"""What commands print and ask for."""
