"""The helical slice against closed solutions and against the solid."""
