"""Which modules are mutated, how many mutants of each group are tried, and by which tests.

A mutant is tried with the tests of the first pattern that its module fits: those that state what
the module does, the quickest first. Not the whole suite, which costs minutes a mutant; nor tests
that compare the code's own digests with the published record, which go red at any change at all.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path


@dataclass(frozen=True)
class Group:
    """Modules that are scored together.

    Attributes
    ----------
    mutants
        How many are tried.
    tests
        Pattern of modules -> test files, the first pattern that fits counts.
    """

    mutants: int
    tests: Mapping[str, tuple[str, ...]]

    def modules(self, root: Path) -> list[str]:
        """Modules of the group, sorted, but for packages' own files and the data sets themselves.

        Those are constants of sensors, each pinned by the hash of the data that come of it.
        """
        folders = sorted({_folder(pattern) for pattern in self.tests})
        found = {
            path.relative_to(root).as_posix()
            for folder in folders
            for path in (root / folder).rglob("*.py")
            if path.name not in {"__init__.py", "__main__.py"}
            and path.parent.name not in {"conditions", "standard"}
        }
        return sorted(found)

    def tests_of(self, module: str) -> tuple[str, ...]:
        """Test files a module's mutants are tried with; LookupError where none is named."""
        for pattern, tests in self.tests.items():
            if fnmatchcase(module, pattern):
                return tests
        raise LookupError(f"no tests are named for the mutants of {module}: see {__file__}")


def _folder(pattern: str) -> str:
    parts = pattern.split("/")
    depth = 1 if parts[0] == "registry" else 2
    return "/".join(parts[:depth])


def _in(folder: str, *names: str) -> tuple[str, ...]:
    return tuple(f"tests/{folder}/test_{name}.py" for name in names)


_METRICS = "benchmark/metrics"
_RUNNING = "benchmark/running"
_RESULTS = "benchmark/results"
_DATASETS = "benchmark/datasets"
_MODELS = "algorithms/models"
_EXTRACTORS = "algorithms/extractors"
_ANSWERS = _in("registry", "answer_accepted", "answer_cases", "answer_brute_force")

GROUPS: Mapping[str, Group] = {
    "metrics": Group(
        50,
        {
            "benchmark/metrics/paired.py": _in(_METRICS, "paired"),
            "benchmark/metrics/posterior_bound.py": _in(_METRICS, "posterior_bound"),
            "benchmark/metrics/score.py": (
                *_in(_METRICS, "score"),
                *_in(_DATASETS, "repeatability"),
            ),
            "benchmark/metrics/ranking.py": _in(_METRICS, "ranking"),
            "benchmark/metrics/rings.py": _in(_METRICS, "rings"),
            "benchmark/metrics/noise_products.py": _in(_METRICS, "common_noise"),
            "benchmark/metrics/noise_products_kernel.py": _in(_METRICS, "common_noise"),
            "benchmark/metrics/bounds.py": _in(_METRICS, "bounds_closed_form", "bounds"),
        },
    ),
    "running": Group(
        45,
        {
            "benchmark/running/kernels.py": _in(_RUNNING, "kernels"),
            "benchmark/running/pinning.py": _in(_RUNNING, "pinning_rules", "pinning"),
            "benchmark/running/times.py": _in(_RUNNING, "times"),
            "benchmark/running/threads.py": _in(_RUNNING, "threads"),
            "benchmark/running/condition_data.py": _in(
                _RUNNING, "condition_data", "pinning_rules", "runner"
            ),
            "benchmark/running/cluster.py": _in(_RUNNING, "cluster_rules"),
            "benchmark/running/compiling.py": _in(_RUNNING, "compiling"),
            "benchmark/running/durations.py": _in(_RUNNING, "durations"),
            "benchmark/running/experiment.py": _in(_RUNNING, "experiment"),
            "benchmark/running/workers.py": _in(_RUNNING, "workers"),
            "benchmark/plan/*": _in(_RUNNING, "plan"),
            "benchmark/running/schedule.py": _in(_RUNNING, "backend", "schedule"),
            "benchmark/running/*": _in(
                _RUNNING, "backend", "runner", "on_bench", "kept_stages", "schedule"
            ),
        },
    ),
    "results": Group(
        50,
        {
            "benchmark/results/closure.py": _in(_RESULTS, "closure"),
            "benchmark/results/analyses.py": _in(_RESULTS, "closure"),
            "benchmark/results/definitions.py": _in(_RESULTS, "closure", "closure_spelling"),
            "benchmark/results/syntax.py": _in(_RESULTS, "closure"),
            "benchmark/results/pipelines.py": _in(_RESULTS, "pipelines"),
            "benchmark/results/parquet_tables.py": _in(_RESULTS, "row_file", "samples"),
            "benchmark/results/record_manifest.py": _in(_RESULTS, "row_file", "samples"),
            "benchmark/results/row_file.py": _in(_RESULTS, "row_file"),
            "benchmark/results/samples.py": _in(_RESULTS, "samples"),
            "benchmark/results/stage_files.py": _in(_RESULTS, "stage_files"),
            "benchmark/results/unchanged.py": _in(_RESULTS, "unchanged"),
            "benchmark/results/digests.py": _in(_RESULTS, "digests"),
            "benchmark/results/components.py": _in(_RESULTS, "components", "record"),
            "benchmark/results/record.py": _in(_RESULTS, "record"),
            "benchmark/results/pins.py": _in(_RESULTS, "store", "row_file", "record"),
            "benchmark/results/*": _in(_RESULTS, "store", "record"),
        },
    ),
    "registry": Group(
        50,
        {
            "registry/flows.py": _in("registry", "registry_order", "flows"),
            "registry/taxonomy.py": _in("registry", "registry_order", "registry_taxonomy"),
            "registry/studies.py": _in("registry", "registry_order", "registry_studies"),
            "registry/resolution.py": _in("registry", "resolution", "resolution_sensors"),
            "registry/fitting.py": _in("registry", "resolution"),
            "registry/sensors.py": _in("registry", "resolution_sensors"),
            "registry/draws.py": _in("registry", "draws", "answer_brute_force"),
            "registry/ranking.py": (*_in("registry", "ranking"), *_ANSWERS),
            "registry/paths.py": _in("registry", "paths"),
            "registry/relaxation.py": (*_in("registry", "relaxation"), *_ANSWERS),
            "registry/evidence.py": _in("api/figures", "evidence_map"),
            "registry/possibility.py": _in("api/figures", "evidence_map"),
            "registry/fidelity/*": _in("registry", "fidelity", "resolution"),
            "registry/catalogue.py": _in("registry", "catalogue", "resolution"),
            "registry/*": (*_in("registry", "draws", "ranking", "requirements"), *_ANSWERS),
        },
    ),
    "datasets": Group(
        45,
        {
            "benchmark/datasets/coverage.py": _in(_DATASETS, "coverage"),
            "benchmark/datasets/benches.py": _in(_DATASETS, "benches", "dataset_parts"),
            "benchmark/datasets/calibration.py": _in(_DATASETS, "calibration", "dataset_parts"),
            "benchmark/datasets/controls.py": _in(_DATASETS, "dataset_parts", "benches"),
            "benchmark/datasets/corrected.py": _in(_DATASETS, "dataset_parts", "benches"),
            "benchmark/datasets/features.py": (
                *_in(_RUNNING, "features_of_corrected"),
                *_in(_DATASETS, "dataset_parts"),
            ),
            "benchmark/datasets/repeats.py": _in(_DATASETS, "repeats_and_units", "dataset_parts"),
            "benchmark/datasets/units.py": _in(_DATASETS, "repeats_and_units", "dataset_parts"),
            "benchmark/datasets/export_verification.py": _in(
                f"{_DATASETS}/exports", "export_parts", "export_verification", "dataset_export"
            ),
            "benchmark/datasets/export*.py": _in(
                f"{_DATASETS}/exports", "export_parts", "dataset_export"
            ),
            "benchmark/datasets/checksums.py": _in(
                f"{_DATASETS}/exports", "export_parts", "dataset_export"
            ),
            "benchmark/datasets/preview*.py": _in(_DATASETS, "dataset_preview"),
            "benchmark/datasets/samples.py": _in(_RESULTS, "digests"),
            "benchmark/datasets/pins.py": (
                *_in(_RESULTS, "store"),
                *_in(_RUNNING, "pinning_rules"),
            ),
            "benchmark/datasets/parameters.py": _in(_DATASETS, "parameters", "dataset_parts"),
            "benchmark/datasets/*": _in(_DATASETS, "dataset_parts"),
        },
    ),
    "models": Group(
        50,
        {
            "algorithms/models/multiplex/*": _in(
                _MODELS, "model_limits", "rulers", "code_dial_models", "coded_masks"
            ),
            "algorithms/models/neural_network/*": _in(
                _MODELS, "network_training_data", "networks", "network_training_step", "selection"
            ),
            "algorithms/models/non_physical/fourier_phase.py": _in(
                _MODELS, "model_limits", "code_dial_models"
            ),
            "algorithms/models/non_physical/*": _in(
                _MODELS,
                "model_limits",
                "fitted_models",
                "regression_models",
                "panel_models",
                "selection",
            ),
            "algorithms/models/lut/*": _in(_MODELS, "model_limits", "fitted_models", "selection"),
            "algorithms/models/geometric/p[ay]*.py": _in(
                _MODELS, "model_limits", "fusion_models", "undisturbed_fusion_models"
            ),
            "algorithms/models/geometric/solar_panel.py": _in(
                _MODELS, "model_limits", "fusion_models", "undisturbed_fusion_models"
            ),
            "algorithms/models/filters.py": (
                *_in(_MODELS, "filter_models", "fusion_models"),
                *_in("algorithms/filtering", "linear_gaussian", "noise_models", "sun_space"),
            ),
            "algorithms/models/geometric/*slit*.py": _in(
                _MODELS, "model_limits", "geometric_models", "slit_models"
            ),
            "algorithms/models/geometric/quadrant_gap.py": _in(
                _MODELS, "model_limits", "quadrant_model"
            ),
            "algorithms/models/physics_informed/*": _in(
                _MODELS, "model_limits", "assembled_faces", "faces_weighing"
            ),
            "algorithms/models/*": _in(
                _MODELS, "model_limits", "geometric_models", "camera_models", "fusion_models"
            ),
        },
    ),
    "extractors": Group(
        60,
        {
            "algorithms/extractors/currents/photodiode.py": _in(_EXTRACTORS, "photodiode"),
            "algorithms/extractors/currents/dial_tracks.py": _in(_MODELS, "code_dial_models"),
            "algorithms/extractors/events/*": _in(
                _EXTRACTORS, "camera_and_event_kernels", "event_centroid"
            ),
            "algorithms/extractors/frames/cameras/black_sun.py": _in(
                _EXTRACTORS, "camera_black_sun"
            ),
            "algorithms/extractors/frames/cameras/dark_holes_kernel.py": _in(
                _EXTRACTORS, "camera_and_event_kernels", "camera_black_sun"
            ),
            "algorithms/extractors/frames/cameras/*": _in(
                _EXTRACTORS, "camera_and_event_kernels", "camera_hough"
            ),
            "algorithms/extractors/frames/energy_filter*.py": _in(
                f"{_EXTRACTORS}/frames", "energy_filter_kernel", "energy_filtering"
            ),
            "algorithms/extractors/frames/mirror/*": _in(
                f"{_EXTRACTORS}/frames/mirror", "mirror_taps", "mirror", "mirror_slit"
            ),
            "algorithms/extractors/frames/multi_spot/*": _in(
                _EXTRACTORS,
                "aperture_grid",
                "extractor_limits",
                "multi_spot_oracles",
                "multi_spot",
                "weighted_spots",
                "pattern_identity",
            ),
            "algorithms/extractors/frames/template*.py": _in(
                _EXTRACTORS, "template_grey", "single_spots"
            ),
            "algorithms/extractors/frames/*": (
                *_in(_EXTRACTORS, "extractor_limits", "frame_kernels", "centroids"),
                *_in(_EXTRACTORS, "single_spots"),
                *_in(f"{_EXTRACTORS}/frames", "single_light"),
            ),
            "algorithms/extractors/profiles/linear_phase.py": _in(
                _EXTRACTORS, "extractor_limits", "profile_lines", "frame_variants"
            ),
            "algorithms/extractors/profiles/peak_detection.py": _in(
                _EXTRACTORS, "extractor_limits", "peak_position", "profile_lines", "frame_variants"
            ),
            "algorithms/extractors/profiles/peak_*.py": _in(
                _EXTRACTORS, "extractor_limits", "peak_position", "profile_lines"
            ),
            "algorithms/extractors/profiles/slit_image*.py": _in(_EXTRACTORS, "slit_image"),
            "algorithms/extractors/profiles/*": _in(
                _EXTRACTORS, "extractor_limits", "profile_lines"
            ),
        },
    ),
}
