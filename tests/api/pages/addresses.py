"""One address of every kind of page."""

from __future__ import annotations

KINDS = {
    "answer": "/",
    "answer, asked": "/?task=Accuracy&max_error_deg=0.1&survive=albedo",
    "answer, nothing left": "/?detector=Event&mask=Lens",
    "answer, refused": "/?detector=CMOSS",
    "studies": "/studies",
    "study": "/studies/Chang2008",
    "algorithms": "/algorithms",
    "extractor": "/algorithms/tm",
    "model": "/algorithms/lsq",
    "chain": "/algorithms/optical%20+%20spm",
    "data sets": "/datasets",
    "data set": "/datasets/cmos-single-aperture",
    "detectors": "/detectors",
    "detector": "/detectors/CMOS",
    "masks": "/masks",
    "mask": "/masks/Single-Ap.",
    "architecture": "/architectures/CMOS/Encoded",
    "claims": "/claims",
    "claim": "/claims/C04",
    "compare": "/compare",
    "compared": "/compare?architecture=CMOS:Encoded&architecture=QPD:Single-Ap.",
    "compared pipelines": "/compare?dataset=ccd-lens&pipeline=bcm:lut"
    "&pipeline=hough-lines:homography",
    "search": "/search",
    "found": "/search?q=centroid",
    "glossary": "/glossary",
    "refused": "/studies/Nobody1900",
    "nowhere": "/nowhere",
}
