"""Several candidates judged at once, and what comes of it for other people's CI: a page, a badge, JUnit, GitHub."""
