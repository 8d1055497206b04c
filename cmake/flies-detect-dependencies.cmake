# What the static library needs.
find_dependency(fmt)
find_dependency(TBB)
find_dependency(hwy)
