"""Laws from Python or MFront."""
