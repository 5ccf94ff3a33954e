"""How the material's functions are compiled: no checks of divisors, multiply-add contracted.

The inner ones are put into their caller.
"""

KERNEL = {"cache": True, "error_model": "numpy", "fastmath": {"contract"}}
INLINE = KERNEL | {"forceinline": True}
PARALLEL = {"cache": True, "parallel": True}  # of functions that call the others for parts of all sections
