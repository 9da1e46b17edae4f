#pragma once
// Stands in for the private header of the same name, which needs OpenCV's build tree, when
// freak.cpp of opencv_contrib is compiled alone.
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/xfeatures2d.hpp>
