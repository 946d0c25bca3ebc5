import cProfile,pstats,io,time
from frbcli.cli.libraries import prepare_libraries
prepare_libraries()
from frbcli.results.store import read_run
run=read_run('/tmp/warm/ref.h5')
from frbcli.plot.run.summary import summary_figure
import frbcli.plot.style as st
f=summary_figure(run); st.save_figure(f,'/tmp/warm/a.png')
f=summary_figure(run)
e=f.get_layout_engine(); f.dpi=150
pr=cProfile.Profile(time.process_time); pr.enable(); e.execute(f); pr.disable()
s=io.StringIO(); pstats.Stats(pr,stream=s).sort_stats('cumulative').print_stats(45); print(s.getvalue()[:7000])
