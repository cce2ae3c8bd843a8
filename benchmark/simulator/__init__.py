"""Sun sensors from light to digits.

One module a part: `light` (the Sun's disc), `masks` (apertures as data), `optics` (cover glass),
`assembly` (misalignment), `detectors` (angular response, dark current, converter), `noise`,
`environment` (irradiance, stray light, Earth albedo). `frames`, `quadrants` and `faces` put the
parts together, one module a kind of observation; `scene` says what a sample is and `sensor` what
every kind offers. `rasteriser` and `areas` are compiled kernels, loaded on first use.
"""

from __future__ import annotations

from typing import Final

#: Raised whenever a change makes the simulator return other numbers; part of every dataset's
#: parameters, so that stored results know which simulator they came from.
SIMULATOR_VERSION: Final = 2
