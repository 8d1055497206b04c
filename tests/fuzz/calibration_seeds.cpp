#include "tests/fuzz/calibration_seeds.hpp"

#include <cmath>

#include "flies/io/formats/rig_texts.hpp"

namespace flies::testing {
namespace {

struct Side {
  cv::Matx33d m;
  std::vector<double> d;  ///< four coefficients
  cv::Mat r, p;           ///< of the rectified view
  cv::Mat in_body;        ///< pose
};

/// The rig of the formats' tests with images of 64 x 48 px, for which rectifying costs little.
struct SmallRig : ToyRig {
  Side left, right;

  SmallRig() {
    const cv::Matx33d tenth(0.1, 0, 0, 0, 0.1, 0, 0, 0, 1);
    const auto to = rectified(*this);
    const auto side = [&](const cv::Matx33d& k, const std::vector<double>& all, const cv::Mat& turn,
                          const cv::Mat& projection, const cv::Mat& in_body) {
      return Side{tenth * k, {all.begin(), all.begin() + 4}, turn, cv::Mat(tenth) * projection, in_body};
    };
    left = side(m1, d1, to.r1, to.p1, body_from_left());
    right = side(m2, d2, to.r2, to.p2, body_from_right(*this));
  }
  std::string pose() const { return rows(right_from_left(*this)); }
};

std::string list_of(const cv::Mat& m) { return list(numbers(m)); }

std::string matrix_lines(const cv::Mat& m) {
  std::string text;
  for (int row = 0; row < m.rows; ++row) text += fmt::format("{}\n", fmt::join(numbers(m.row(row)), " "));
  return text;
}

std::string kalibr(const SmallRig& rig) {
  const auto camera = [](const Side& s) {
    return "  camera_model: pinhole\n  distortion_coeffs: " + list(s.d) +
           "\n  distortion_model: radtan\n  intrinsics: " + focal_and_centre(s.m) + "\n  resolution: [64, 48]\n";
  };
  return "cam0:\n" + camera(rig.left) + "cam1:\n  T_cn_cnm1: " + rig.pose() + "\n" + camera(rig.right);
}

/// Lenses that only Kalibr and Basalt have.
std::string kalibr_spheres(const SmallRig& rig) {
  const auto camera = [](const char* model, const char* first) {
    return fmt::format("  camera_model: {}\n  intrinsics: [{}, 32, 24]\n  resolution: [64, 48]\n", model, first);
  };
  return "cam0:\n" + camera("ds", "-0.24, 0.57, 26, 26") + "cam1:\n  T_cn_cnm1: " + rig.pose() + "\n" +
         camera("ds", "-0.24, 0.57, 26, 26");
}

std::string euroc(const Side& s) {
  return "%YAML:1.0\nT_BS:\n  cols: 4\n  rows: 4\n  data: " + list_of(s.in_body) +
         "\nresolution: [64, 48]\ncamera_model: pinhole\nintrinsics: " + focal_and_centre(s.m) +
         "\ndistortion_model: radial-tangential\ndistortion_coefficients: " + list(s.d) + "\n";
}

std::string orb_slam3(const SmallRig& rig) {
  const auto camera = [](const char* name, const Side& s) {
    return fmt::format("{0}.fx: {1}\n{0}.fy: {2}\n{0}.cx: {3}\n{0}.cy: {4}\n", name, s.m(0, 0), s.m(1, 1), s.m(0, 2),
                       s.m(1, 2)) +
           fmt::format("{0}.k1: {1}\n{0}.k2: {2}\n{0}.p1: {3}\n{0}.p2: {4}\n", name, s.d[0], s.d[1], s.d[2], s.d[3]);
  };
  return "%YAML:1.0\nFile.version: \"1.0\"\nCamera.type: \"PinHole\"\n" + camera("Camera1", rig.left) +
         camera("Camera2", rig.right) + "Camera.width: 64\nCamera.height: 48\n" +
         opencv_matrix("Stereo.T_c1_c2", right_from_left(rig).inv());
}

std::string orb_slam2(const SmallRig& rig) {
  const auto camera = [](const std::string& name, const Side& s) {
    return name + ".height: 48\n" + name + ".width: 64\n" + opencv_matrix(name + ".D", cv::Mat(s.d).t(), ":") +
           opencv_matrix(name + ".K", cv::Mat(s.m)) + opencv_matrix(name + ".R", s.r) + opencv_matrix(name + ".P", s.p);
  };
  return "%YAML:1.0\nCamera.fx: 40\nCamera.fy: 40\nCamera.cx: 32\nCamera.cy: 24\nCamera.bf: 4.8\n" +
         camera("LEFT", rig.left) + camera("RIGHT", rig.right);
}

std::string stella_vslam(const SmallRig& rig) {
  const auto camera = [](const char* name, const Side& s) {
    return fmt::format("  K_{0}: {1}\n  D_{0}: {2}\n  R_{0}: {3}\n", name, list_of(cv::Mat(s.m)), list(s.d),
                       list_of(s.r));
  };
  return "Camera:\n  setup: \"stereo\"\n  model: \"perspective\"\n  fx: 40\n  fy: 40\n  cx: 32\n  cy: 24\n"
         "  cols: 64\n  rows: 48\n  focal_x_baseline: 4.8\nStereoRectifier:\n" +
         camera("left", rig.left) + camera("right", rig.right);
}

std::string okvis(const SmallRig& rig) {
  const auto camera = [](const Side& s) {
    return "     - {T_SC:\n        " + list_of(s.in_body) + ", image_dimension: [64, 48],\n        " +
           "distortion_coefficients: " + list(s.d) +
           ", distortion_type: radialtangential,\n        focal_length: " + list({s.m(0, 0), s.m(1, 1)}) +
           ", principal_point: " + list({s.m(0, 2), s.m(1, 2)}) + "}\n";
  };
  return "%YAML:1.0\ncameras:\n" + camera(rig.left) + camera(rig.right);
}

std::string ov2slam(const SmallRig& rig) {
  const auto camera = [](const char* side, char end, const Side& s) {
    return fmt::format("Camera.model_{0}: pinhole\nCamera.{0}_nwidth: 64\nCamera.{0}_nheight: 48\nCamera.fx{1}: {2}\n",
                       side, end, s.m(0, 0)) +
           fmt::format("Camera.fy{0}: {1}\nCamera.cx{0}: {2}\nCamera.cy{0}: {3}\nCamera.k1{0}: {4}\n", end, s.m(1, 1),
                       s.m(0, 2), s.m(1, 2), s.d[0]) +
           fmt::format("Camera.k2{0}: {1}\nCamera.p1{0}: {2}\nCamera.p2{0}: {3}\n", end, s.d[1], s.d[2], s.d[3]);
  };
  return "%YAML 1.0\n---\n" + camera("left", 'l', rig.left) + camera("right", 'r', rig.right) +
         opencv_matrix("body_T_cam0", rig.left.in_body) + opencv_matrix("body_T_cam1", rig.right.in_body);
}

std::string kimera(const SmallRig& rig) {
  const auto camera = [](const std::string& side, const Side& s) {
    return side + "_camera_intrinsics: " + focal_and_centre(s.m) + "\n" + side +
           "_camera_distortion_coefficients: " + list(s.d) + "\n" + side + "_camera_extrinsics: " + list_of(s.in_body) +
           "\n";
  };
  return "camera_model: pinhole\ndistortion_model: radial-tangential\ncamera_resolution: [64, 48]\n" +
         camera("left", rig.left) + camera("right", rig.right);
}

/// The configuration and the files of both cameras.
std::string vins(const SmallRig& rig) {
  const auto camera = [](const Side& s) {
    return "%YAML:1.0\n---\nmodel_type: PINHOLE\nimage_width: 64\nimage_height: 48\ndistortion_parameters:\n" +
           fmt::format("   k1: {}\n   k2: {}\n   p1: {}\n   p2: {}\n", s.d[0], s.d[1], s.d[2], s.d[3]) +
           fmt::format("projection_parameters:\n   fx: {}\n   fy: {}\n   cx: {}\n   cy: {}\n", s.m(0, 0), s.m(1, 1),
                       s.m(0, 2), s.m(1, 2));
  };
  return "%YAML:1.0\n---\ncam0_calib: \"cam1.yaml\"\ncam1_calib: \"cam2.yaml\"\n" +
         opencv_matrix("body_T_cam0", rig.left.in_body) + opencv_matrix("body_T_cam1", rig.right.in_body) + '\0' +
         camera(rig.left) + '\0' + camera(rig.right);
}

std::string zed() {
  const auto camera = [](const char* side) {
    return fmt::format("[{}_CAM_VGA]\nfx=350\nfy=350\ncx=336\ncy=188\nk1=-0.17\nk2=0.024\np1=0\np2=0\nk3=0\n", side);
  };
  return camera("LEFT") + camera("RIGHT") + "[STEREO]\nBaseline=120\nTY=0.1\nCV_VGA=0.01\nRX_VGA=0\nRZ_VGA=0\n";
}

std::string depthai(const SmallRig& rig) {
  const auto camera = [](int socket, const Side& s, int to, const cv::Mat& pose) {
    return fmt::format("[{}, {{\"cameraType\": 0, \"distortionCoeff\": {}, \"height\": 48, \"width\": 64, ", socket,
                       list({s.d[0], s.d[1], s.d[2], s.d[3], 0, 0, 0, 0, 0, 0, 0, 0, 0, 0})) +
           fmt::format("\"intrinsicMatrix\": {}, \"extrinsics\": {{\"rotationMatrix\": {}, \"toCameraSocket\": {}, ",
                       rows(cv::Mat(s.m)), rows(pose(cv::Rect(0, 0, 3, 3))), to) +
           fmt::format("\"translation\": {{\"x\": {}, \"y\": {}, \"z\": {}}}}}}}]", 100 * pose.at<double>(0, 3),
                       100 * pose.at<double>(1, 3), 100 * pose.at<double>(2, 3));
  };
  return "{\"cameraData\": [" + camera(1, rig.left, 2, right_from_left(rig)) + ", " +
         camera(2, rig.right, -1, cv::Mat::eye(4, 4, CV_64F)) +
         "], \"stereoRectificationData\": {\"leftCameraSocket\": 1, \"rightCameraSocket\": 2}, \"version\": 7}";
}

std::string basalt() {
  const std::string camera =
      R"({"camera_type": "ds", "intrinsics": {"fx": 26, "fy": 26, "cx": 32, "cy": 24, "xi": -0.24, "alpha": 0.57}})";
  return R"({"value0": {"T_imu_cam": [{"px": 0, "py": 0, "pz": 0, "qx": 0, "qy": 0, "qz": 0, "qw": 1}, )"
         R"({"px": 0.12, "py": 0, "pz": 0, "qx": 0, "qy": 0.01, "qz": 0, "qw": 0.99995}], "intrinsics": [)" +
         camera + ", " + camera + R"(], "resolution": [[64, 48], [64, 48]]}})";
}

std::string matlab(const SmallRig& rig) {
  const auto camera = [](const Side& s) {
    return fmt::format(
        R"({{"RadialDistortion": [{}, {}], "TangentialDistortion": [{}, {}], "ImageSize": [48, 64], "K": {}}})", s.d[0],
        s.d[1], s.d[2], s.d[3], rows(cv::Mat(s.m)));
  };
  return R"({"CameraParameters1": )" + camera(rig.left) + R"(, "CameraParameters2": )" + camera(rig.right) +
         R"(, "PoseCamera2": {"R": )" + rows(cv::Mat(rig.r)) + R"(, "Translation": )" + list_of(cv::Mat(1e3 * rig.t)) +
         "}}";
}

std::string realsense(const SmallRig& rig, const std::string& stream, const std::string& model) {
  const auto camera = [&](const char* number, const cv::Matx33d& m) {
    return fmt::format(" Intrinsic of \"{} {}\"\t  / 64x48 / {{Y8}}\n  Width:     \t64\n  Height:    \t48\n", stream,
                       number) +
           fmt::format("  PPX:        \t{}\n  PPY:        \t{}\n  Fx:         \t{}\n  Fy:         \t{}\n", m(0, 2),
                       m(1, 2), m(0, 0), m(1, 1)) +
           "  Distortion: \t" + model + "\n  Coeffs:     \t0  \t0  \t0  \t0  \t0  \n\n";
  };
  return camera("1", rig.left.m) + camera("2", rig.right.m) +
         fmt::format("Extrinsic from \"{0} 1\"\t  To\t  \"{0} 2\" :\n Rotation Matrix:\n", stream) +
         matrix_lines(cv::Mat(rig.r)) +
         fmt::format("\n Translation Vector: {}  {}  {}  \n", rig.t[0], rig.t[1], rig.t[2]);
}

std::string kitti_raw(const SmallRig& rig) {
  const auto camera = [](const char* n, const Side& s) {
    const cv::Mat pose = s.in_body.inv();
    return fmt::format("S_{0}: 64 48\nK_{0}: {1}\nD_{0}: {2} 0\nR_{0}: {3}\n", n, fmt::join(numbers(cv::Mat(s.m)), " "),
                       fmt::join(s.d, " "), fmt::join(numbers(pose(cv::Rect(0, 0, 3, 3))), " ")) +
           fmt::format("T_{0}: {1}\nS_rect_{0}: 64 48\nP_rect_{0}: {2}\n", n,
                       fmt::join(numbers(pose(cv::Rect(3, 0, 1, 3))), " "), fmt::join(numbers(s.p), " "));
  };
  return camera("02", rig.left) + camera("03", rig.right);
}

/// What ROS's calibrator writes.
std::string ost(const SmallRig& rig) {
  const auto camera = [](const char* name, const Side& s) {
    return "# oST version 5.0 parameters\n\n[image]\n\nwidth\n64\n\nheight\n48\n\n[" + std::string(name) +
           "]\n\ncamera matrix\n" + matrix_lines(cv::Mat(s.m)) + "\ndistortion\n" + matrix_lines(cv::Mat(s.d).t()) +
           "\nrectification\n" + matrix_lines(s.r) + "\nprojection\n" + matrix_lines(s.p) + "\n";
  };
  return camera("left", rig.left) + camera("right", rig.right);
}

/// The two files of OpenCV's sample of stereo calibration.
std::string opencv_files(const SmallRig& rig) {
  return "%YAML:1.0\n---\nimage_width: 64\nimage_height: 48\n" + opencv_matrix("M1", cv::Mat(rig.left.m)) +
         opencv_matrix("D1", cv::Mat(rig.left.d).t()) + opencv_matrix("M2", cv::Mat(rig.right.m)) +
         opencv_matrix("D2", cv::Mat(rig.right.d).t()) + '\0' + "%YAML:1.0\n---\n" +
         opencv_matrix("R", cv::Mat(rig.r)) + opencv_matrix("T", cv::Mat(rig.t)) + opencv_matrix("P1", rig.left.p) +
         opencv_matrix("P2", rig.right.p);
}

/// As our own writers have it, of rectified images and of raw ones.
std::vector<std::string> written(const SmallRig& rig) {
  RawStereo raw;
  raw.width_px = 64;
  raw.height_px = 48;
  std::copy_n(rig.left.m.val, 9, raw.left.matrix.begin());
  std::copy_n(rig.right.m.val, 9, raw.right.matrix.begin());
  raw.left.distortion = rig.left.d;
  raw.right.distortion = rig.right.d;
  std::copy_n(rig.r.val, 9, raw.rotation.begin());
  std::copy_n(rig.t.val, 3, raw.translation_m.begin());
  Calibration of_raw;
  of_raw.rectifier.emplace(raw, "rig");
  Calibration plain;
  plain.camera = of_raw.camera = of_raw.rectifier->camera();
  std::vector<std::string> texts;
  const auto add = [&](const Calibration& calibration, CalibrationSyntax syntax) {
    const auto [text, right] = calibration_texts(calibration, syntax);
    texts.push_back(right.empty() ? text : text + '\0' + right);
  };
  for (const auto syntax :
       {CalibrationSyntax::kitti, CalibrationSyntax::opencv, CalibrationSyntax::ros, CalibrationSyntax::yaml})
    add(plain, syntax);
  for (const auto syntax : {CalibrationSyntax::opencv, CalibrationSyntax::ros}) add(of_raw, syntax);
  return texts;
}

}  // namespace

std::vector<std::string> calibration_seeds() {
  const SmallRig rig;
  SmallRig level = rig;  // as RealSense's cameras of the D400 series rectify
  level.r = cv::Matx33d::eye();
  level.t = {-0.05, 0, 0};
  level.right.m = level.left.m;
  auto seeds = written(rig);
  seeds.insert(seeds.end(),
               {kalibr(rig), kalibr_spheres(rig), euroc(rig.left) + '\0' + euroc(rig.right), orb_slam3(rig),
                orb_slam2(rig), stella_vslam(rig), okvis(rig), ov2slam(rig), kimera(rig), vins(rig), zed(),
                depthai(rig), basalt(), matlab(rig), realsense(level, "Infrared", "Brown Conrady"),
                realsense(rig, "Fisheye", "Kannala Brandt4"), kitti_raw(rig), ost(rig), opencv_files(rig)});
  // Rectified cameras of a handful of numbers.
  seeds.insert(
      seeds.end(),
      {"718 0 607 0 0 718 185 0 0 0 1 0\n718 0 607 -386 0 718 185 0 0 0 1 0\n",
       "cam0=[700 0 600; 0 700 170; 0 0 1]\ncam1=[700 0 600; 0 700 170; 0 0 1]\ndoffs=0\nbaseline=100\nwidth=1242\n"
       "height=375\n",
       "754 0 489 0 754 265 0 0 1\n0.063\n",
       R"({"fx": 500, "fy": 500, "cx0": 320, "cx1": 321, "cy": 240, "baseline_meters": 0.1, "width": 640, )"
       R"("height": 480})",
       "<?xml version=\"1.0\"?>\n<opencv_storage><FocalLengthX>704</FocalLengthX><FocalLengthY>704</FocalLengthY>"
       "<CenterX>320</CenterX><CenterY>240</CenterY><BaseLine>0.3</BaseLine><Height>1.17</Height><Tilt>0.08</Tilt>"
       "</opencv_storage>\n",
       R"({"extrinsic": {"baseline": 0.2, "pitch": 0.038, "z": 1.22}, "intrinsic": {"fx": 2262, "fy": 2265, )"
       R"("u0": 1096, "v0": 513}})"});
  // Raw cameras of so many pixels that tables for them would take gigabytes.
  seeds.push_back(
      "cam0:\n"
      "  camera_model: pinhole\n"
      "  distortion_coeffs: [-0.28, 0.07, 0.0005, -0.0003]\n"
      "  distortion_model: radtan\n"
      "  intrinsics: [12600, 12600, 10000, 10000]\n"
      "  resolution: [20000, 20000]\n"
      "cam1:\n"
      "  T_cn_cnm1:\n"
      "  - [1, 0, 0, -0.12]\n"
      "  - [0, 1, 0, 0]\n"
      "  - [0, 0, 1, 0]\n"
      "  - [0, 0, 0, 1]\n"
      "  camera_model: pinhole\n"
      "  distortion_coeffs: [-0.28, 0.07, 0.0005, -0.0003]\n"
      "  distortion_model: radtan\n"
      "  intrinsics: [12600, 12600, 10000, 10000]\n"
      "  resolution: [20000, 20000]\n");
  return seeds;
}

}  // namespace flies::testing
