"""Commands that fit constants to measured springs and compare with them."""
