"""Constants of a wire from what a spring tester reads: force over travel of springs that are pressed and released."""
