"""Puts `raw_sensors`, whose rows these tests read, where they find it."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
