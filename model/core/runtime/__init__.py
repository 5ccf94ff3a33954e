"""Libraries, caches, processes and threads."""
