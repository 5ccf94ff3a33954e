"""Integration of the law at one point."""
