// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hypertexture_geom/params/parameter.h"

// Every object of a scene file, declared once: validation, schema and reference documentation come
// from here. The field of a hypertexture geometry is declared in hypertexture_geom/field.
namespace morsel::render {

const params::Declaration& scene_declaration();
const params::Declaration& camera_declaration();
const params::Declaration& render_declaration();

const params::Declaration& image_texture_declaration();
const params::Declaration& ramp_texture_declaration();
const params::Declaration& checker_texture_declaration();

const params::Declaration& model_declaration();

const params::Declaration& diffuse_declaration();
const params::Declaration& conductor_declaration();
const params::Declaration& dielectric_declaration();
const params::Declaration& principled_declaration();

const params::Declaration& mesh_declaration();
const params::Declaration& rectangle_declaration();
const params::Declaration& sphere_declaration();

const params::Declaration& instance_declaration();

const params::Declaration& environment_light_declaration();
const params::Declaration& sky_light_declaration();
const params::Declaration& rectangle_light_declaration();
const params::Declaration& disk_light_declaration();
const params::Declaration& sphere_light_declaration();
const params::Declaration& point_light_declaration();
const params::Declaration& distant_light_declaration();

}  // namespace morsel::render
