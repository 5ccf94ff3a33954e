"""Wire that is not round: its section, and how two such wires touch."""
