"""How the material's functions are compiled: no checks of divisors, multiply-add contracted.

The inner ones are put into their caller. No wrapper for C is made, which nothing calls and takes a tenth of the time.
"""

KERNEL = {"cache": True, "error_model": "numpy", "fastmath": {"contract"}, "no_cfunc_wrapper": True}
INLINE = KERNEL | {"forceinline": True}
