"""Forces and moments of the seats, and their balance."""
