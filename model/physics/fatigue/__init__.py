"""Fatigue of the wire's surface between two states of the spring: criteria of stress, and life by a Wöhler line."""
