import h5py,numpy as np,sys
f=h5py.File(sys.argv[1]+'/run.h5'); ks=list(f['snapshots']); s0=f['snapshots'][ks[0]]; s=f['snapshots'][ks[-1]]
def by(s): 
    o=np.argsort(s['id'][:]); return s['position'][:][o], s['orientation'][:][o]
p0,q0=by(s0); p,q=by(s); skip=5; i=0
out=open(sys.argv[3],'w')
for line in open(sys.argv[2]):
    if line.startswith('b '):
        w=line.split(); qf=np.array(list(map(float,w[10:14])))
        if i==0: print(qf,q0[skip])
        w[7:10]=['%.17g'%x for x in p[skip+i]]; w[10:14]=['%.17g'%x for x in q[skip+i]]; i+=1
        line=' '.join(w)+'\n'
    out.write(line)
