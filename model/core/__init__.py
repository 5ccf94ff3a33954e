"""The mechanics of one run: nothing in it imports a package of physics or tools."""
