#pragma once

namespace cairn::host {

/// The same camera in every format.
inline constexpr const char* kOpenCv = R"(%YAML:1.0
---
calibration_time: "Mon 01 Jan 2024"
image_width: 640
image_height: 480
flags: 0
fisheye_model: 0
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 5.1e+02, 0., 3.2e+02, 0., 5.2e+02, 2.4e+02, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ 0.1, -0.2, 0.001, -0.002, 0. ]
avg_reprojection_error: 0.2
)";

inline constexpr const char* kOpenCvXml = R"(<?xml version="1.0"?>
<opencv_storage>
<image_width>640</image_width>
<image_height>480</image_height>
<camera_matrix type_id="opencv-matrix">
  <rows>3</rows><cols>3</cols><dt>d</dt>
  <data>510. 0. 320. 0. 520. 240. 0. 0. 1.</data></camera_matrix>
<distortion_coefficients type_id="opencv-matrix">
  <rows>1</rows><cols>5</cols><dt>d</dt>
  <data>0.1 -0.2 0.001 -0.002 0.</data></distortion_coefficients>
</opencv_storage>
)";

inline constexpr const char* kOpenCvJson = R"({
	"image_width": 640,
	"image_height": 480,
	"camera_matrix": {
		"type_id": "opencv-matrix", "rows": 3, "cols": 3, "dt": "d",
		"data": [ 510.0, 0.0, 320.0, 0.0, 520.0, 240.0, 0.0, 0.0, 1.0 ]
	},
	"distortion_coefficients": {
		"type_id": "opencv-matrix", "rows": 1, "cols": 4, "dt": "d",
		"data": [ 0.1, -0.2, 0.001, -0.002 ]
	}
})";

inline constexpr const char* kPython =
    R"({"image_width": 640, "image_height": 480, "dist_coeff": [[0.1, -0.2, 0.001, -0.002, 0.0]],
    "camera_matrix": [[510.0, 0.0, 320.0], [0.0, 520.0, 240.0], [0.0, 0.0, 1.0]]})";

inline constexpr const char* kRos = R"(image_width: 640
image_height: 480
camera_name: front
camera_matrix:
  rows: 3
  cols: 3
  data: [510, 0, 320, 0, 520, 240, 0, 0, 1]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [0.1, -0.2, 0.001, -0.002, 0]
)";

inline constexpr const char* kRosTopic = R"(header:
  seq: 3
  frame_id: "camera"
height: 480
width: 640
distortion_model: "plumb_bob"
D: [0.1, -0.2, 0.001, -0.002, 0.0]
K: [510.0, 0.0, 320.0, 0.0, 520.0, 240.0, 0.0, 0.0, 1.0]
R: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
P: [500.0, 0.0, 321.0, 0.0, 0.0, 510.0, 241.0, 0.0, 0.0, 0.0, 1.0, 0.0]
binning_x: 0
binning_y: 0
roi:
  x_offset: 0
  y_offset: 0
  height: 480
  width: 640
  do_rectify: False
---
)";

inline constexpr const char* kKalibr = R"(cam0:
  camera_model: pinhole
  distortion_model: radtan
  distortion_coeffs: [0.1, -0.2, 0.001, -0.002]
  intrinsics: [510, 520, 320, 240]
  resolution: [640, 480]
cam1:
  camera_model: omni
  distortion_model: equidistant
  distortion_coeffs: [1, 1, 1, 1]
)";

inline constexpr const char* kEuroc = R"(sensor_type: camera
comment: VI-Sensor cam0 (MT9M034)
T_BS:
  cols: 4
  rows: 4
  data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
rate_hz: 20
resolution: [640, 480]
camera_model: pinhole
intrinsics: [510, 520, 320, 240] #fu, fv, cu, cv
distortion_model: radial-tangential
distortion_coefficients: [0.1, -0.2, 0.001, -0.002]
)";

inline constexpr const char* kOrbSlam2 =
    "%YAML:1.0\nCamera.fx: 510\nCamera.fy: 520\nCamera.cx: 320\nCamera.cy: 240\n"
    "Camera.k1: 0.1\nCamera.k2: -0.2\nCamera.p1: 0.001\nCamera.p2: -0.002\n"
    "Camera.width: 640\nCamera.height: 480\nCamera.fps: 30.0\nORBextractor.nLevels: 8\n";

inline constexpr const char* kOrbSlam3 =
    "%YAML:1.0\nFile.version: \"1.0\"\nCamera.type: \"PinHole\"\nCamera1.fx: 510\n"
    "Camera1.fy: 520\nCamera1.cx: 320\nCamera1.cy: 240\nCamera1.k1: 0.1\nCamera1.k2: -0.2\n"
    "Camera1.p1: 0.001\nCamera1.p2: -0.002\nCamera2.fx: 9\nCamera2.k1: 5\nCamera.width: 640\n"
    "Camera.height: 480\nCamera.newWidth: 600\n";

inline constexpr const char* kVins = R"(%YAML:1.0
---
model_type: PINHOLE
camera_name: camera
image_width: 640
image_height: 480
distortion_parameters:
   k1: 0.1
   k2: -0.2
   p1: 0.001
   p2: -0.002
projection_parameters:
   fx: 510
   fy: 520
   cx: 320
   cy: 240
)";

inline constexpr const char* kBasalt = R"({"value0": {
  "T_imu_cam": [{"px": 0, "py": 0, "pz": 0, "qx": 0, "qy": 0, "qz": 0, "qw": 1}],
  "intrinsics": [{"camera_type": "pinhole-radtan8", "intrinsics": {
    "fx": 510, "fy": 520, "cx": 320, "cy": 240, "k1": 0.1, "k2": -0.2, "p1": 0.001, "p2": -0.002,
    "k3": 0, "k4": 0, "k5": 0, "k6": 0, "rpmax": 2.5}}],
  "resolution": [[640, 480]]}})";

inline constexpr const char* kColmap =
    "# Camera list with one line of data per camera:\n"
    "#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n"
    "1 OPENCV 640 480 510 520 320.5 240.5 0.1 -0.2 0.001 -0.002\n";

}  // namespace cairn::host
