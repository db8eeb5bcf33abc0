// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hypertexture_geom/params/parameter.h"

// Parameters that several declarations of scene files share.
namespace morsel::render {

inline params::Parameter type_parameter(const char* type, bool required) {
  return {.name = "type",
          .type = params::Type::kChoice,
          .default_value = required ? nlohmann::json(nullptr) : nlohmann::json(type),
          .help = "kind",
          .choices = {type}};
}

inline params::Parameter name_parameter(const char* help) {
  return {.name = "name", .type = params::Type::kString, .help = help};
}

inline params::Parameter optional_name_parameter(const char* help) {
  return {.name = "name", .type = params::Type::kString, .default_value = "", .help = help};
}

// A number in [0, 1].
inline params::Parameter share_parameter(const char* name, double default_value, const char* help) {
  return {.name = name, .default_value = default_value, .help = help, .min = 0.0, .max = 1.0};
}

// A colour in [0, 1].
inline params::Parameter tint_parameter(const char* name, nlohmann::json default_value,
                                        const char* help) {
  return {.name = name,
          .type = params::Type::kColor,
          .default_value = std::move(default_value),
          .help = help,
          .min = 0.0,
          .max = 1.0};
}

inline params::Parameter flag_parameter(const char* name, bool default_value, const char* help) {
  return {
      .name = name, .type = params::Type::kBoolean, .default_value = default_value, .help = help};
}

inline params::Parameter radiance_parameter(const char* name, const char* help) {
  return {.name = name,
          .type = params::Type::kNumberOrVector3,
          .default_value = 1.0,
          .help = help,
          .min = 0.0,
          .max = 1e9};
}

inline params::Parameter point_parameter(const char* name, const char* help) {
  return {.name = name,
          .type = params::Type::kVector3,
          .help = help,
          .unit = "length",
          .min = -params::kFarthest,
          .max = params::kFarthest};
}

inline params::Parameter depth_parameter(const char* name, const char* help) {
  return {.name = name,
          .type = params::Type::kInteger,
          .default_value = 1024,
          .help = help,
          .min = 0,
          .max = 1024};
}

}  // namespace morsel::render
