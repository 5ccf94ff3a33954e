"""The one reader of YAML: safe, and every complaint with its line and column."""

from pathlib import Path

import yaml

from coilset.model.errors import InputError


class _Loader(yaml.SafeLoader):
    """Safe YAML that refuses an entry given twice."""

    def construct_mapping(self, node, deep=False):
        seen = set()
        for key, _ in node.value:
            if not isinstance(key, yaml.ScalarNode):
                raise yaml.MarkedYAMLError(problem="an entry's name must be a word", problem_mark=key.start_mark)
            if key.value in seen:
                problem = f"the entry '{key.value}' is given twice"
                raise yaml.MarkedYAMLError(problem=problem, problem_mark=key.start_mark)
            seen.add(key.value)
        return super().construct_mapping(node, deep)


def load_yaml(text, file):
    """Parse YAML safely; InputError with line and column if that fails."""
    try:
        return yaml.load(text, Loader=_Loader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        place = f"line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        raise InputError(f"not readable as YAML: {error.problem}", place, file) from None
    except yaml.YAMLError as error:
        raise InputError("not readable as YAML: " + " ".join(str(error).split()), "", file) from None


def read_data(path, kind="a case file holds entries such as spring:, material: and loading:"):
    """Read a YAML file of entries, unchecked.

    Args:
        path: the YAML file.
        kind: what such a file holds, for a file that is no mapping.

    Returns:
        dict.

    Raises:
        InputError: if it cannot be read.
    """
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not a text file"
        raise InputError(f"the file cannot be read: {reason}", "", path) from None
    data = load_yaml(text, path)
    if not isinstance(data, dict):
        raise InputError(kind, "", path)
    return data
