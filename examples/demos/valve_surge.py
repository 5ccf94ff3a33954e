# %% [markdown]
# # Surge of a valve spring at 3,000 1/min
#
# A cam opens a valve in a few milliseconds. For the spring this is not slow: its own waves take as long to run from
# one end to the other, so that the force on the valve and on the cylinder head are not those of a slow press. Here
# the spring is pressed to its installed length, and then its top seat is driven by the lift; inertia, large
# deflections and the contact of coils and seats take part. The wire stays elastic.

# %%
import matplotlib as mpl
import matplotlib.figure
import numpy as np
from scipy.optimize import minimize_scalar

from coilset.api import Case, modes, solve, surge

installed, lift, engine = 42.0, 8.5, 3000.0  # mm, mm, revolutions per minute
case = Case(
    {
        "spring": {
            "wire_diameter": 4.0,
            "mean_diameter": 28.0,
            "turns": 8.0,
            "free_length": 52.0,
            "end_coils": "closed and ground",
        },
        "material": "elastic",
        "mesh": {"elements_per_turn": 8, "section": {"radial": 2, "angular": 8}},
        "loading": [{"to": {"height": installed}, "steps": 4}],
        "accuracy": "none",
    }
)

# %% [markdown]
# ## The lift
#
# The camshaft runs at half the engine's speed; the valve is open for 110° of it. A curve with smooth acceleration
# stands for the cam's: $(1 - ξ^2)^3$, where $ξ$ goes from −1 to 1.

# %%
open_for = 110.0 / 360.0 * 2.0 * 60.0 / engine  # s


def height(time):
    """Of the top seat, mm."""
    ξ = 2.0 * time / open_for - 1.0
    return installed - lift * max(1.0 - ξ * ξ, 0.0) ** 3


# %% [markdown]
# ## Steps of time
#
# The method (generalised-α) is of second order for waves that the steps resolve. A second run with steps twice as long
# shows how far forces depend on them. A little energy is taken from oscillations that they do not resolve; how much is
# stated.

# %%
seconds, step = 0.024, 1.5e-4
coarse, fine = (surge(case, height, seconds, Δt) for Δt in (2.0 * step, step))
error = fine.force_error(coarse)
loss = fine.lost[-1] / fine.supplied.max()
slow = solve(case.change({"loading": [{"to": {"height": installed - lift}, "steps": 12}]}))
still = np.interp(-fine.height, -52.0 + slow.travel, slow.force)
print(f"bottom: {fine.bottom.max():.0f} N, slowly {still.max():.0f} N; error of the steps {error:.1f} N")
print(f"closed contacts: {fine.contacts[0]} when installed, up to {fine.contacts.max()}")
print(f"energy lost in the steps: {100.0 * loss:.3f} % of what the valve supplies")
assert error < 0.035 * still.max()
assert 0.0 < loss < 1e-3
assert fine.bottom.max() > still.max() + 1.5 * error

# %% [markdown]
# ## After the valve has closed
#
# The spring goes on ringing at its first axial frequency, which `modes` finds from stiffness and mass alone.

# %%
closed = fine.time > open_for + 2e-3
time, ringing = fine.time[closed], (fine.top - fine.bottom)[closed]
found = modes(case, count=6)
axial = found.frequencies[found.masses[:, 2].argmax()]


def rest(f):
    """What a sine of the frequency f leaves of the ringing."""
    sines = np.stack([np.sin(2.0 * np.pi * f * time), np.cos(2.0 * np.pi * f * time), np.ones_like(time)], axis=1)
    return np.linalg.lstsq(sines, ringing, rcond=None)[1][0]


rings = minimize_scalar(rest, bounds=(0.8 * axial, 1.2 * axial), method="bounded").x
print(f"rings at {rings:.0f} Hz, first axial mode {axial:.0f} Hz")
assert abs(rings / axial - 1.0) < 0.025

# %%
with mpl.rc_context({"font.size": 9}):
    figure = mpl.figure.Figure(figsize=(9.0, 3.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    ms = 1e3 * fine.time
    left.plot(ms, still, "k:", lw=1.0, label="pressed slowly")
    left.plot(ms, fine.top, "C0-", lw=1.3, label="at the valve (top)")
    left.plot(ms, fine.bottom, "C1-", lw=1.3, label="at the cylinder head (bottom)")
    left.set(xlabel="time, ms", ylabel="force, N", title=f"A lift of {lift:g} mm at {engine:,.0f} 1/min")
    right.plot(ms, fine.height, "k-", lw=1.0, label="top seat")
    stations = fine.level.shape[1]
    for turn in range(1, 8):
        level = fine.level[:, turn * (stations - 1) // 8]
        right.plot(ms, level, "C0-", lw=1.0, label="the wire after each turn" if turn == 1 else None)
    right.set(xlabel="time, ms", ylabel="height, mm", title="The wave in the coils", ylim=(0.0, 55.0))
    for axes in (left, right):
        axes.grid(lw=0.3)
        axes.legend(loc="upper right")
