"""One address of every kind of page."""

from __future__ import annotations

from api.figures.catalogue import MATRIX, TITLES

KINDS = {
    "answer": "/",
    "answer, asked": "/?task=Accuracy&max_error_deg=0.1&tolerate=albedo",
    "answer, on a bench": "/?max_error_deg=0.02&bench_deg=0.05&detector=CMOS&detector=CCD",
    "answer, over poses": "/?mission=leo-cubesat&across=poses",
    "answer, nothing left": "/?detector=Event&mask=Lens",
    "answer, refused": "/?detector=CMOSS",
    "studies": "/studies",
    "study": "/studies/Chang2008",
    "study without a mask": "/studies/Delgado2010",
    "algorithms": "/algorithms",
    "extractor": "/algorithms/tm",
    "model": "/algorithms/lsq",
    "chain": "/algorithms/optical%20+%20spm",
    "data sets": "/datasets",
    "data set": "/datasets/cmos-single-aperture",
    "leaderboard": "/leaderboard",
    "leaderboard, in another order": "/leaderboard?order=bound",
    "detectors": "/detectors",
    "detector": "/detectors/CMOS",
    "masks": "/masks",
    "mask": "/masks/Single-Ap.",
    "architecture": "/architectures/CMOS/Encoded",
    "claims": "/claims",
    "claim": "/claims/C04",
    "directions": "/directions",
    "experiments": "/experiments",
    "experiment": "/experiments/learning_curves",
    "compare": "/compare",
    "compared": "/compare?architecture=CMOS:Encoded&architecture=QPD:Single-Ap.",
    "compared pipelines": "/compare?dataset=ccd-lens&pipeline=bcm:lut"
    "&pipeline=hough-lines:homography",
    "search": "/search",
    "found": "/search?q=centroid",
    "glossary": "/glossary",
    "bibliography": "/bibliography",
    "figures": "/figures",
    **{f"figure {name}": f"/figures/{name}" for name in TITLES},
    "figure narrowed": f"/figures/{next(iter(TITLES))}?detector=CMOS",
    "evidence map": f"/figures/{MATRIX}",
    "gap": "/figures/gap",
    "trade-off": "/figures/trade-off?across=latency&level=own&dataset=ccd-slit"
    "&select=ccd-slit:slit-image:slit",
    "robustness": "/figures/robustness?hazard=saturation&hazard=glare",
    "pairwise": "/figures/robustness?compare=mirror&compare=bctm",
    "refused": "/studies/Nobody1900",
    "nowhere": "/nowhere",
}
#: Pages that are not made of the templates, but stand in the same place.
BESIDE = {"guide": "/guide/index.html", "guide, prose": "/guide/guide/scores.html"}
