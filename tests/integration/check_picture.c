/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Says what is in a picture of viewer.c: shares of rock, triangles and background, how many islands the rock's pixels
 * form (8 neighbours), and the share of triangle pixels in shadow.
 *
 *   check_picture PICTURE.ppm   ->   "WIDTH HEIGHT rock R triangles T background B islands N shadow S"
 */
#include <stdio.h>
#include <stdlib.h>

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  FILE* file = fopen(argv[1], "rb");
  int width, height;
  if (!file || fscanf(file, "P6 %d %d 255", &width, &height) != 2 || width < 1 || height < 1 ||
      width > 10000 || height > 10000 || fgetc(file) != '\n') {
    fprintf(stderr, "%s: not a picture\n", argv[1]);
    return 1;
  }
  const size_t pixels = (size_t)width * (size_t)height;
  unsigned char* rgb = malloc(3 * pixels);
  unsigned char* is_rock = calloc(pixels, 1);
  size_t* stack = malloc(pixels * sizeof *stack);
  if (!rgb || !is_rock || !stack || fread(rgb, 3, pixels, file) != pixels || fgetc(file) != EOF) {
    fprintf(stderr, "%s: too short or too long\n", argv[1]);
    return 1;
  }
  fclose(file);
  size_t rock = 0, triangles = 0, background = 0, shadow = 0, islands = 0;
  for (size_t i = 0; i < pixels; ++i) {
    const int r = rgb[3 * i], b = rgb[3 * i + 2];
    if (r > b)
      is_rock[i] = 1, ++rock;
    else if (b > r)
      ++triangles, shadow += b < 70; /* the ambient light alone gives 57 */
    else
      ++background;
  }
  for (size_t i = 0; i < pixels; ++i) {
    if (!is_rock[i]) continue;
    ++islands;
    size_t top = 0;
    stack[top++] = i, is_rock[i] = 0;
    while (top > 0) {
      const size_t at = stack[--top];
      const int x = (int)(at % (size_t)width), y = (int)(at / (size_t)width);
      for (int v = y - 1; v <= y + 1; ++v)
        for (int u = x - 1; u <= x + 1; ++u) {
          if (u < 0 || v < 0 || u >= width || v >= height) continue;
          const size_t next = (size_t)v * (size_t)width + (size_t)u;
          if (is_rock[next]) is_rock[next] = 0, stack[top++] = next;
        }
    }
  }
  const double all = (double)pixels;
  printf("%d %d rock %.4f triangles %.4f background %.4f islands %zu shadow %.4f\n", width, height,
         (double)rock / all, (double)triangles / all, (double)background / all, islands,
         triangles ? (double)shadow / (double)triangles : 0.0);
  free(rgb);
  free(is_rock);
  free(stack);
  return 0;
}
