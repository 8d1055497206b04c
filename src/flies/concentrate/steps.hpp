#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "flies/concentrate/concentrate_options.hpp"
#include "flies/concentrate/concentrate_result.hpp"
#include "flies/concentrate/pixel_grid.hpp"
#include "flies/concentrate/sightings.hpp"
#include "flies/core/field.hpp"
#include "flies/core/road.hpp"
#include "flies/core/stereo_camera.hpp"

/// The steps of concentrate.hpp on memory that is kept: what they fill is the last parameters.
namespace flies {

std::size_t count_view_angles(const ConcentrateOptions& options);

/// @param fullest memory for intervals
void sample_histograms(const Sightings& flies, const FieldOptions& field, const ConcentrateOptions& options,
                       std::vector<std::size_t>& fullest, HistogramAxis& axis, std::vector<ViewAngle>& views);

/// One entry per sighting.
void drop_flies(const Sightings& flies, const Projection& projection, const RoadPlane& road,
                std::vector<DroppedFly>& dropped);

/// Of the flies that the grid was filled with for `kernels::kKernelReach` bandwidths.
void shift_means(const PixelGrid& flies, const ConcentrateOptions& options, std::span<ShiftedPoint> points);

/// @param population the number n of flies, fit or not
void find_density(std::span<const PixelPoint> points, const PixelGrid& flies, std::size_t population,
                  double bandwidth_px, std::vector<double>& density);

}  // namespace flies
