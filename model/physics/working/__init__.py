"""The finished spring at its working lengths."""
