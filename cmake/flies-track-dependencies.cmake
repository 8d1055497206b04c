# What the static library needs.
include("${CMAKE_CURRENT_LIST_DIR}/FliesOpenCV.cmake")
flies_find_opencv(core imgproc features2d video calib3d)
find_dependency(fmt)
