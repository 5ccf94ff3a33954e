"""Geometry and meshes of springs: centre lines, line meshes, solid meshes of a coil section, import and export."""
