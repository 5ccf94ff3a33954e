"""What steps leave wrong, sections of finer rules, coarse meshes and effort."""
