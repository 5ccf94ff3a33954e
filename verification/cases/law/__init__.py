"""The law at a point and in a bar."""
