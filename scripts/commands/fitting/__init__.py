"""Commands that learn from measured springs."""
