"""A form's function of one element, as FFCx wrote it, compiled for several elements at a time.

FFCx's C function of a line element is long and has nothing that a processor's vector registers could take at once: a
chain of scalar products and sums. So it is compiled once more with a number of LANES elements in the place of each
double: GNU C's vectors, which gcc and clang have. A loop around it, in C too, brings the values of LANES elements
together and takes their matrices apart again. Each lane is computed as if it were alone, so that an element's matrix
does not depend on its neighbours.

T. Sun et al., A study of vectorization for matrix-free finite element methods, Int. J. High Perform. Comput. Appl. 34
(2020), find the same to be the way for short loops over quadrature points.
"""

import hashlib
import importlib.util
import os
import re
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import cffi
import ffcx.codegeneration
import numpy as np
from dolfinx.jit import mpi_jit_decorator
from llvmlite import binding

from coilset.model.core.base.errors import CoilsetError
from coilset.model.core.rod.assembly import blocks

# As many as fill a register of 512 bits, or one of 256: with two registers for each value of FFCx's function, most of
# which are live for long, more time goes into moving them to memory and back than the second one saves.
FEATURES = binding.get_host_cpu_features()
LANES = 8 if FEATURES.get("avx512f") else 4
PROCESSOR = binding.get_host_cpu_name() + FEATURES.flatten()
OPTIONS = ["-std=gnu17", "-O1", "-march=native", "-fno-math-errno", "-fno-trapping-math", "-Wno-psabi"]
BLOCK = 256  # elements whose tangents, 1.6 or 4.6 kB each, fit into a processor's second cache
HEADER = f"""
#include <math.h>
#include <stdint.h>
#include <string.h>
#define LANES {LANES}
typedef double lanes __attribute__((vector_size(LANES * sizeof(double))));
#define EACH(function) static inline lanes each_##function(lanes x) \\
    {{ for (int k = 0; k < LANES; ++k) x[k] = function(x[k]); return x; }}
EACH(sqrt)
EACH(fabs)
#define sqrt each_sqrt
#define fabs each_fabs
"""
# The cells' node numbers, the coefficients with the length of each, and what is written; see ElementKernel.
DECLARATION = """void tabulate_elements(long elements, const double *x, const int32_t *nodes, long coefficients,
    const double *const *values, const long *lengths, long width, long size, double *out)"""
FUNCTION = r"^void (tabulate_tensor_\w+)\((.*?)\)\n\{(.*?)^\}\n\n(?:bool|ufcx_integral) "  # of an element, in FFCx's C
LOOP = """
{{
  lanes A[size], w[width], c[6];
  for (long first = 0; first < elements; first += LANES) {{
    for (int k = 0; k < LANES; ++k) {{
      const long e = first + k < elements ? first + k : elements - 1;
      double *to = (double *)w + k;
      for (long i = 0; i < coefficients; ++i) {{
        const double *from = values[i] + e * lengths[i];
        for (long j = 0; j < lengths[i]; ++j, to += LANES) *to = from[j];
      }}
      for (int j = 0; j < 6; ++j) c[j][k] = x[3 * nodes[2 * e + j / 3] + j % 3];
    }}
    memset(A, 0, sizeof A);
    {function}(A, {rest});
    const long count = elements - first < LANES ? elements - first : LANES;
    for (long k = 0; k < count; ++k) {{
      double *to = out + (first + k) * size;
      const double *from = (const double *)A + k;
      for (long i = 0; i < size; ++i) to[i] = from[i * LANES];
    }}
  }}
}}
"""

OWN = Path(__file__).read_text(encoding="utf-8")  # with FFCx's C, all that the compiled loop depends on
Loop = tuple[Any, Any]  # the FFI of a compiled module, and its function


class ElementKernel:
    """The function of a form for all elements of a rod.

    Args:
        loop: of a form with one integral over the cells, line elements of two nodes, see `load`.
        fields: values of the coefficients that it reads, in its order, each of shape (cells, …).
        x: positions of the nodes, shape (nodes, 3), mm.
        nodes: of the cells, shape (cells, 2), 32-bit whole numbers.
        shape: of an element's tensor.

    The arrays are read where they are, at each call. Elements are taken in blocks, whose tensors the next one writes
    over: those of all are as large as the matrix, and would be written to memory and read from it again.
    """

    def __init__(
        self,
        loop: Loop,
        fields: Sequence[np.ndarray],
        x: np.ndarray,
        nodes: np.ndarray,
        shape: tuple[int, ...],
    ) -> None:
        cells = len(fields[0])
        self._out = np.zeros((min(BLOCK, cells), *shape))
        self._kept = fields, x, nodes  # C holds their addresses only
        self._ffi, self._function = loop
        lengths = [int(np.prod(field.shape[1:])) for field in fields]
        fixed = self._ffi.new("long[]", lengths), sum(lengths), int(np.prod(shape)), self._pointer(self._out)
        self._blocks = []
        for block in blocks(slice(0, cells), BLOCK):
            values = self._ffi.new("double *[]", [self._pointer(field[block]) for field in fields])
            places = self._pointer(x), self._pointer(nodes[block], "int32_t *")
            self._blocks.append((block, (block.stop - block.start, *places, len(fields), values, *fixed)))

    def _pointer(self, values: np.ndarray, kind: str = "double *") -> Any:
        if not values.flags.c_contiguous:
            raise ValueError("the values of a coefficient must lie one after the other")
        return self._ffi.cast(kind, values.ctypes.data)

    def __call__(self) -> Iterator[tuple[slice, np.ndarray]]:
        """Some elements after others, and their tensors, shape (elements, …)."""
        for block, arguments in self._blocks:
            self._function(*arguments)
            yield block, self._out[: arguments[0]]


@mpi_jit_decorator
def make(compiled: Any) -> Path:
    """The file of the loop over the elements for DOLFINx's CompiledForm; `make(comm, compiled)` is collective."""
    module = Path(compiled.module.__file__)
    text = module.with_name(f"{compiled.module.__name__}.c").read_text(encoding="utf-8")
    content = hashlib.sha256("".join([text, OWN, PROCESSOR]).encode()).hexdigest()[:16]
    path = module.with_name(f"coilset_elements_{content}{''.join(module.suffixes)}")
    if not path.is_file():
        _compile(path, _source(text))
    return path


def load(file: str) -> Loop:
    """The compiled loop of a file.

    Raises:
        ImportError: if there is none.
    """
    found = importlib.util.spec_from_file_location(Path(file).name.split(".")[0], file)
    assert found is not None
    assert found.loader is not None
    loaded = importlib.util.module_from_spec(found)
    found.loader.exec_module(loaded)
    return loaded.ffi, loaded.lib.tabulate_elements


def _source(text: str) -> str:
    """C of the loop, from the C that FFCx wrote."""
    found = re.findall(FUNCTION, text, re.M | re.S)
    if len(found) != 1:
        raise CoilsetError(f"FFCx wrote {len(found)} functions of an element; one was expected")
    name, parameters, body = found[0]
    function = re.sub(r"(?<!static const )\bdouble\b", "lanes", f"static void {name}({parameters})\n{{{body}}}\n")
    function = re.sub(r"= 0(\.0)?;", "= {0};", function)
    rest = ", ".join(["w", "0", "c"] + ["0"] * (parameters.count(",") - 3))
    return HEADER + function + DECLARATION + LOOP.format(function=name, rest=rest)


def _compile(path: Path, text: str) -> None:
    """Compile beside `path` and put the result there; others may do the same at the same time."""
    builder = cffi.FFI()
    builder.cdef(DECLARATION + ";")
    builder.set_source(
        path.name.split(".")[0], text, extra_compile_args=OPTIONS, include_dirs=[ffcx.codegeneration.get_include_path()]
    )
    with tempfile.TemporaryDirectory(dir=path.parent) as folder:
        os.replace(builder.compile(tmpdir=folder), path)
