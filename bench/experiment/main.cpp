#include <cstdio>
#include "bench/experiment/trial.h"
#include "bench/experiment/trip.h"
using namespace trapeze; using namespace trapeze::experiment;
int main(int argc,char**argv){
  Screen screen; printf("%s\n", screen.renderer().description().c_str());
  for (auto& ms : known_maps("/work/shared/data","/work/main/data")) {
    if (argc>1 && ms.name!=argv[1]) continue;
    Map map=load_map(ms);
    printf("%s: %zu polygons %zu vertices\n", ms.name.c_str(), map.polygon_count(), map.vertex_count());
    auto trip=plan_trip(map,{});
    printf("empty %.1f\n", empty_view_ms(map.layers.size(), screen));
    for (auto m: kMethods) for (auto t:{Topology::strict,Topology::fast}) if (is_possible(m,t)) {
      auto r=run_trial(m,t,map,trip,1,screen);
      ViewCost sum; for(auto&v:r.views){sum.simplify_ms+=v.simplify_ms;sum.tessellate_ms+=v.tessellate_ms;sum.send_ms+=v.send_ms;sum.draw_ms+=v.draw_ms;sum.vertices+=v.vertices;sum.trapezoids+=v.trapezoids;sum.bytes+=v.bytes;}
      printf("%-8s %d prep %.0f mem %.1fM | simp %.2f tess %.2f send %.2f draw %.2f total %.2f | v %llu t %llu b %llu\n", std::string(name_of(m)).c_str(),(int)t,r.prepare_ms,r.memory/1e6,sum.simplify_ms/72,sum.tessellate_ms/72,sum.send_ms/72,sum.draw_ms/72,sum.total_ms()/72,(unsigned long long)sum.vertices/72,(unsigned long long)sum.trapezoids/72,(unsigned long long)sum.bytes/72);
      auto&v=r.views[0]; printf("      first: simp %.2f tess %.2f send %.2f draw %.2f t %llu\n",v.simplify_ms,v.tessellate_ms,v.send_ms,v.draw_ms,(unsigned long long)v.trapezoids);
      fflush(stdout);
    }
  }
}
