{% autoescape false %}
/* Runs a recorded cycle through the controller, and prints the largest difference from the law in Python. */
#include "controller.h"

#include <math.h>
#include <stdio.h>
#include <time.h>

#define STEPS 100000

typedef struct {
  int event; /* just before the sample */
  double t, q[SPEAR_COORDINATES], v[SPEAR_COORDINATES], u[SPEAR_JOINTS];
} sample;

static const sample record[] = {
{% for row in rows %}
  { {{ row.event }}, {{ row.t }}, { {{ row.q | join(", ") }} }, { {{ row.v | join(", ") }} }, { {{ row.u | join(", ") }} } }{{ "," if not loop.last }}
{% endfor %}
};

int main(void)
{
  const int count = (int)(sizeof record / sizeof record[0]);
  spear_controller c;
  double u[SPEAR_JOINTS], worst = 0.0, most = 0.0, sum = 0.0;
  clock_t begin;
  int i, j;
  spear_init(&c, 1, record[0].t, record[0].q, record[0].v);
  for (i = 0; i < count; ++i) {
    const sample *s = &record[i];
    if (s->event != SPEAR_NOTHING && !spear_event(&c, s->event, s->t, s->q, s->v)) {
      printf("event %d does not happen in phase %d\n", s->event, c.phase);
      return 1;
    }
    spear_torques(&c, s->t, s->q, s->v, u);
    for (j = 0; j < SPEAR_JOINTS; ++j) {
      most = fmax(most, fabs(s->u[j]));
      worst = fmax(worst, fabs(u[j] - s->u[j]));
    }
  }
  begin = clock();
  spear_init(&c, 1, record[0].t, record[0].q, record[0].v);
  for (i = 0; i < STEPS; ++i) {
    const sample *s = &record[i % count];
    if (i % count == 0) spear_init(&c, 1, s->t, s->q, s->v);
    spear_step(&c, s->t, s->q, s->v, u);
    sum += u[0];
  }
  printf("largest difference: %.3g N.m, of torques up to %.3g N.m, in %d samples\n", worst, most, count);
  printf("a step takes %.3g us (sum of torques %.6g N.m)\n", 1e6 * (double)(clock() - begin) / CLOCKS_PER_SEC / STEPS, sum);
  return worst <= 1e-12 * fmax(1.0, 0.01 * most) ? 0 : 1;
}
{% endautoescape %}
