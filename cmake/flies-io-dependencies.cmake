# What the static library needs.
include("${CMAKE_CURRENT_LIST_DIR}/FliesOpenCV.cmake")
flies_find_opencv(core imgproc calib3d objdetect dnn)
find_dependency(JPEG)
find_dependency(PNG)
find_dependency(TIFF)
find_dependency(yaml-cpp)
find_dependency(pugixml)
find_dependency(fmt)
