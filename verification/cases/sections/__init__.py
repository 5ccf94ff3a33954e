"""Cross-sections against exact integrals and the solid."""
