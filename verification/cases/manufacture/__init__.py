"""Coiling and peening."""
