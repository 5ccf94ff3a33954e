"""How the material's functions are compiled: no checks of divisors, multiply-add contracted.

The inner ones are put into their caller. Those that threads call let go of the lock of Python.
"""

KERNEL = {"cache": True, "error_model": "numpy", "fastmath": {"contract"}}
INLINE = KERNEL | {"forceinline": True}
OF_THREADS = KERNEL | {"nogil": True}
