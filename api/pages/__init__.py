"""Pages rendered on the server: one module a kind of page, each with its JSON and CSV twin.

`serving.PageRouter.page` is how a module offers a page; `rendering` turns it into HTML with the
templates of `templates/`, all of which extend `base.html`. `routers` lists the modules.
"""
