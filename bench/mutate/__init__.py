"""`bladeatlas-bench mutate`: whether the tests of an area fail when its code is changed."""
