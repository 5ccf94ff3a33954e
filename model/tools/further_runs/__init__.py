"""Companions of a run that show its errors, finer runs, and the finished spring at its working lengths."""
