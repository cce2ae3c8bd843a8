"""Facts tied to code: the survey's vocabulary, its studies, and what can be run of them.

Start at `registry.studies.facts` (studies and taxonomy), `registry.catalogue.catalogue`
(implementations), `registry.resolution.resolve`, `registry.flows.flows` and
`registry.recommendation.recommend`. Importing this package loads nothing: the survey is read at
the first question, the implementations at the first `catalogue()`.
"""
