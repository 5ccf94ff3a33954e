"""The input of an analysis: case files, their entries, and how they are read and checked."""

from coilset.model.core.case.case import Case, UnloadedCase, check, read_case, read_case_data

__all__ = ["Case", "UnloadedCase", "check", "read_case", "read_case_data"]
