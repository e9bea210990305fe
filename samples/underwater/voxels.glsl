// SPDX-License-Identifier: MIT
// Plants and fish: kelp's surface function (shaders/surface.glsl), after water.glsl.

vec4 kelpSurface(KelpSurface s) {
  vec3 sunlight = waterSunlight(s.position);
  // Of the leaf's own neighbors by rays, which are sharp; of all else, by the map.
  bool near = kelpOccluded(s.position + 0.015 * s.normal, water_sun.xyz, 0.35);
  float shadow = near ? 0.25 : mix(0.25, 1.0, waterSunlit(s.position + 0.35 * water_sun.xyz));
  vec3 diffuse = s.color.rgb * (1.0 - s.metallic);
  vec3 specular = mix(vec3(0.03), s.color.rgb, s.metallic);
  // kelp's own light for a sun of this color; leaves let some of it through to the side that is turned away.
  vec3 lit = kelpSunLight(s, diffuse, specular) * sunlight / max(kelp_sun_color, vec3(1e-3));
  vec3 through = diffuse * diffuse * sunlight * (0.40 * max(dot(-s.normal, water_sun.xyz), 0.0));
  vec3 color = shadow * (lit + through) + diffuse * waterAmbient(s.position, s.normal) + s.emissive;
  return vec4(waterSeen(color, s.position), 1.0);
}
