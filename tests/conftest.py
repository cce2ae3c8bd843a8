"""No test judges how long something took: the machine may be busy with other things."""

from __future__ import annotations

import os

# A worker of xdist has a core of its own; threads of BLAS beside it would wait for each other.
# Said before NumPy is loaded, and to the processes that tests start.
for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(name, "1")

from hypothesis import HealthCheck, settings  # noqa: E402

settings.register_profile(
    "any-machine", deadline=None, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("any-machine")
